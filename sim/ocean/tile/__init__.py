"""The periodic tile of linear waves: `Sea`, its surface, its rings and its transforms."""
