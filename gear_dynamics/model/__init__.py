"""The gear pair: parameters, geometry, mesh, equations, integrator."""
