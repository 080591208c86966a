"""Drawing on viser: meshes, water, cameras, gizmos, dragging, and the scripts for the page."""
