"""Decides how often to measure, and when it is enough. Knows neither GL nor files."""
