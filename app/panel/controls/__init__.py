"""The controls of a scene's parameters, and the texts among them."""
