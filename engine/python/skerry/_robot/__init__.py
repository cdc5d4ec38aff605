"""Robots of URDF and MJCF files."""

from .description import Drive, Frame, Robot, RobotJoint, RobotLink
from .placed import PlacedRobot, add_robot
from .plan import PlannedBody, PlannedJoint, RobotPlan, plan_robot
from .read_file import load_robot

__all__ = [
    "Drive",
    "Frame",
    "PlacedRobot",
    "PlannedBody",
    "PlannedJoint",
    "Robot",
    "RobotJoint",
    "RobotLink",
    "RobotPlan",
    "add_robot",
    "load_robot",
    "plan_robot",
]
