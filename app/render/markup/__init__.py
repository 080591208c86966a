"""Text, formulas and charts as HTML and SVG."""
