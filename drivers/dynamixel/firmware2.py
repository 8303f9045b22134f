"""The control tables of MX servos with firmware for protocol 2.0, in the manual's order and words."""

import math

from drivers.dynamixel.firmware1 import TICK
from drivers.dynamixel.registers import Register, Signed

SPEED_STEP = 0.229 * 2 * math.pi / 60
"""rad/s: one step of every velocity, 0.229 rev/min."""

ACCELERATION_STEP = 214.577 * 2 * math.pi / 3600
"""rad/s²: one step of Profile Acceleration, 214.577 rev/min²."""

# https://emanual.robotis.com/docs/en/dxl/mx/mx-28-2/#control-table-of-eeprom-area
_SHARED = {
    "Model Number": Register(0, 2),
    "Model Information": Register(2, 4),
    "Firmware Version": Register(6, 1),
    "ID": Register(7, 1),
    "Baud Rate": Register(8, 1),  # 0 to 7: 9600, 57600, 115200, 1 M, 2 M, 3 M, 4 M, 4.5 M bit/s
    "Return Delay Time": Register(9, 1, unit="s", per_lsb=2e-6),
    "Drive Mode": Register(10, 1),
    "Operating Mode": Register(11, 1),
    "Secondary(Shadow) ID": Register(12, 1),
    "Protocol Version": Register(13, 1),
    "Homing Offset": Register(20, 4, Signed.TWOS, unit="rad", per_lsb=TICK),
    "Moving Threshold": Register(24, 4, unit="rad/s", per_lsb=SPEED_STEP),
    "Temperature Limit": Register(31, 1, unit="degrees Celsius"),
    "Max Voltage Limit": Register(32, 2, unit="V", per_lsb=0.1),
    "Min Voltage Limit": Register(34, 2, unit="V", per_lsb=0.1),
    "PWM Limit": Register(36, 2, per_lsb=1 / 885),
    "Acceleration Limit": Register(40, 4, unit="rad/s²", per_lsb=ACCELERATION_STEP),
    "Velocity Limit": Register(44, 4, unit="rad/s", per_lsb=SPEED_STEP),
    "Max Position Limit": Register(48, 4, unit="rad", per_lsb=TICK),
    "Min Position Limit": Register(52, 4, unit="rad", per_lsb=TICK),
    "Shutdown": Register(63, 1),
    "Torque Enable": Register(64, 1),
    "LED": Register(65, 1),
    "Status Return Level": Register(68, 1),
    "Registered Instruction": Register(69, 1),
    "Hardware Error Status": Register(70, 1),
    "Velocity I Gain": Register(76, 2),
    "Velocity P Gain": Register(78, 2),
    "Position D Gain": Register(80, 2),
    "Position I Gain": Register(82, 2),
    "Position P Gain": Register(84, 2),
    "Feedforward 2nd Gain": Register(88, 2),
    "Feedforward 1st Gain": Register(90, 2),
    "BUS Watchdog": Register(98, 1, unit="s", per_lsb=0.02),  # 0: off; -1: tripped
    "Goal PWM": Register(100, 2, Signed.TWOS, per_lsb=1 / 885),
    "Goal Velocity": Register(104, 4, Signed.TWOS, unit="rad/s", per_lsb=SPEED_STEP),
    "Profile Acceleration": Register(108, 4, unit="rad/s²", per_lsb=ACCELERATION_STEP),  # 0: infinite
    "Profile Velocity": Register(112, 4, unit="rad/s", per_lsb=SPEED_STEP),  # 0: infinite
    "Goal Position": Register(116, 4, Signed.TWOS, unit="rad", per_lsb=TICK),
    "Realtime Tick": Register(120, 2, unit="s", per_lsb=1e-3),
    "Moving": Register(122, 1),
    "Moving Status": Register(123, 1),
    "Present PWM": Register(124, 2, Signed.TWOS, per_lsb=1 / 885),
    "Present Velocity": Register(128, 4, Signed.TWOS, unit="rad/s", per_lsb=SPEED_STEP),
    "Present Position": Register(132, 4, Signed.TWOS, unit="rad", per_lsb=TICK),
    "Velocity Trajectory": Register(136, 4, Signed.TWOS, unit="rad/s", per_lsb=SPEED_STEP),
    "Position Trajectory": Register(140, 4, Signed.TWOS, unit="rad", per_lsb=TICK),
    "Present Input Voltage": Register(144, 2, unit="V", per_lsb=0.1),
    "Present Temperature": Register(146, 1, unit="degrees Celsius"),
}

MX_28 = _SHARED | {
    "Present Load": Register(126, 2, Signed.TWOS, per_lsb=1e-3),
}

# https://emanual.robotis.com/docs/en/dxl/mx/mx-64-2/#control-table-of-eeprom-area
MX_64 = _SHARED | {
    "Current Limit": Register(38, 2, unit="A", per_lsb=3.36e-3),
    "Goal Current": Register(102, 2, Signed.TWOS, unit="A", per_lsb=3.36e-3),
    "Present Current": Register(126, 2, Signed.TWOS, unit="A", per_lsb=3.36e-3),
}

# https://emanual.robotis.com/docs/en/dxl/mx/mx-106-2/#control-table-of-eeprom-area
MX_106 = MX_64

# https://emanual.robotis.com/docs/en/dxl/protocol2/#error
RESULTS = (
    "",
    "Result Fail",
    "Instruction Error",
    "CRC Error",
    "Data Range Error",
    "Data Length Error",
    "Data Limit Error",
    "Access Error",
)
"""What the number in a status packet's error byte says about the instruction; 0: carried out."""

ALERT = 0x80
"""The bit of that byte which says that Hardware Error Status has the cause."""

# https://emanual.robotis.com/docs/en/dxl/mx/mx-28-2/#shutdown
HARDWARE_ERRORS = (
    "Input Voltage Error",
    "",
    "Overheating Error",
    "Motor Encoder Error",
    "Electrical Shock Error",
    "Overload Error",
)
"""Names of the bits of Hardware Error Status and of Shutdown, from bit 0."""

OLDEST_WITH_WATCHDOG = 38
"""Firmware that has the BUS Watchdog, https://emanual.robotis.com/docs/en/dxl/mx/mx-28-2/#bus-watchdog."""

TRIPPED = 0xFF
"""BUS Watchdog, -1 in the manual: the bus was quiet for too long, the servo stopped and takes no goals."""
