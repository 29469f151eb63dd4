"""Real-time vibration of a simulated spur gear pair; no ROS is needed for this API."""

from gear_dynamics.model.gear_pair import GearPair
from gear_dynamics.model.parameter import ParameterError

__all__ = ['GearPair', 'ParameterError']
