"""What is told of the liquid: probes, planes, loads, sums, and how the steps went."""
