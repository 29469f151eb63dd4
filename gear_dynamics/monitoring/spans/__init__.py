"""Analysis of a machine span by span: levels, orders, wheels and bearings, from any channels."""
