"""Pages of the joint laws: equation, response along displacement paths, parameters, source."""
