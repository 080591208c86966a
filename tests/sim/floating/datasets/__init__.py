"""Small datasets of Capytaine's, and the script that makes them."""
