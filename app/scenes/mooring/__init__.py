"""The mooring: a floating body on lines between the bed and the water's surface."""
