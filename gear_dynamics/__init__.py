"""Real-time vibration of a simulated spur gear pair; no ROS is needed for this API."""

from gear_dynamics.model.parameter import ParameterError
from gear_dynamics.parameter_files import GearPair

__all__ = ['GearPair', 'ParameterError']
