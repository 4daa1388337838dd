"""The studies behind the figures and reports of the papers."""
