"""Numbers that everything else uses: angles modulo a turn, roots, cosine and sine of turns."""
