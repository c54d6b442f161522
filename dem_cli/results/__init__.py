"""Results of a run: files, pictures, movies, pages."""
