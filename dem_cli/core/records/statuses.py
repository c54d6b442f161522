"""Statuses with which runs end, as summary.json lists them."""

FALLS = "does not stand under its dead loads"  # status of a run of any kind, of limit analysis too
BUCKLED = "buckled under its dead loads"  # the same where forces balance, and the tangent stiffness is negative
ABOVE = "above what this geometry can carry"  # status of a failure load above its bound that nothing explains
COLLAPSED, STOOD, ROCKS, MOVES = "collapsed", "stood", "still rocking", "still moving"  # ends of time histories
