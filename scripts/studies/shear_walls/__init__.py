"""Study of the dry-stone shear walls of Lourenço et al. 2005."""
