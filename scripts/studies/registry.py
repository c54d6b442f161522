"""Registry of the studies: name of the command, module, what it is about."""

from __future__ import annotations

STUDIES = {  # module with STUDY, sentence of the list
    "appendix_b": ("studies.appendix_b.study", "thesis Appendix B: walls with loads on top"),
    "bounds": ("studies.bounds.study", "bounds of failure loads, from above and below, beside DEM"),
    "buildings": ("studies.buildings.study", "buildings from their plan: CPU and memory of each stage"),
    "chapter6": ("studies.chapter6.study", "thesis chapter 6: shaken blocks, column and arch"),
    "chapter7": ("studies.chapter7.study", "thesis chapter 7: joints that are not plane"),
    "church": ("studies.church.study", "thesis Appendix A: the slice of a church"),
    "costs": ("studies.costs.study", "what `dem check` says that runs cost, and what they cost"),
    "deformable": ("studies.deformable.study", "joints and blocks that deform: points, lumped blocks"),
    "gallery": ("studies.gallery", "the pictures of docs/gallery.md"),
    "geometries": ("studies.geometries.study", "random structures in fixed and in moving geometry, beside their bound"),
    "imperfections": ("studies.imperfections.study", "the 21-block wall with one block too low (thesis 5.4)"),
    "interrupts": ("studies.interrupts.study", "Ctrl-C and SIGTERM at random moments of every command"),
    "laws": ("studies.laws.study", "a page and a picture of every joint law"),
    "loads": ("studies.loads.study", "failure loads by limit analysis and by DEM"),
    "mortar": ("studies.mortar.study", "mortar joints in space: bending and torsion, wallettes at any angle"),
    "motions": ("studies.motions", "artificial accelerograms and response spectra"),
    "motion_in_space": ("studies.motion_in_space.study", "blocks that move in space: exact motions, twins, structures"),
    "paper001": ("studies.paper001.study", "paper 001: walls of regular, Voronoi and coursed stones, a stone house"),
    "profile": ("studies.profile", "the moment that a joint with a profile carries"),
    "pulses": ("studies.pulses.study", "published pulse tests of a column and two arches"),
    "random_structures": (
        "studies.stress.random_structures.study",
        "random structures: every method between rigorous bounds",
    ),
    "rocking": ("studies.rocking.study", "blocks that rock, slide and bounce, against exact motions"),
    "shear_walls": ("studies.shear_walls.study", "dry-stone shear walls: capacity curves over their tests"),
    "space": ("studies.space.study", "failure loads in space: by hand, planar twins, walls that meet"),
    "stress": ("studies.stress.study", "the stability stress test: try to break the program"),
    "thesis_joint": ("studies.thesis_joint", "one structure on the thesis's own joint"),
    "vaults": ("studies.vaults.study", "vaults, domes and bridges against closed forms and limit analysis"),
}
