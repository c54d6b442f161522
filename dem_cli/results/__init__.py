"""Write, draw and report the results of a run: files, pictures, movies, pages."""
