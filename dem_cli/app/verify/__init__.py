"""`dem verify`: which cases have a reference, how near they come to it, and the page that says so."""
