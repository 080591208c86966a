"""The control panel: controls made from parameters, plots, presets, the stability map."""
