"""Generate buildings: walls from their axes in plan, bonded where they meet, with openings, gables and floors."""
