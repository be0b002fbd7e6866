"""What benches compare with: charts, scenes, metrics, lenses in OSL."""
