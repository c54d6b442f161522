"""Vaults in space against closed forms: least thickness, hoops, thrust, a moving axle."""
