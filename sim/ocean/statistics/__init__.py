"""Statistics of seas: heights and periods, high crests, slopes and foam."""
