"""Assembly of a model: blocks of a case into arrays, laid, checked, with their errors."""
