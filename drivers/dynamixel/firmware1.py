"""The control tables of servos that speak protocol 1.0, as data, in the manual's order and words."""

import math

from drivers.dynamixel.registers import Register, Signed

TICK = 2 * math.pi / 4096
"""rad: one step of a position of an MX, 0.088 degrees."""

AX_TICK = math.radians(300) / 1024
"""rad: one step of a position of an AX, 0.29 degrees; its sensor sees 300 degrees and nothing of the rest."""

SPEED_STEP = 0.114 * 2 * math.pi / 60
"""rad/s: one step of Moving Speed and Present Speed of an MX, 0.114 rev/min."""

AX_SPEED_STEP = 0.111 * 2 * math.pi / 60
"""rad/s: the same of an AX, 0.111 rev/min."""

ACCELERATION_STEP = math.radians(8.583)
"""rad/s²: one step of Goal Acceleration."""

# https://emanual.robotis.com/docs/en/dxl/mx/mx-28/#control-table-of-eeprom-area
MX_28 = {
    "Model Number": Register(0, 2),
    "Firmware Version": Register(2, 1),
    "ID": Register(3, 1),
    "Baud Rate": Register(4, 1),  # 2,000,000 / (value + 1) bit/s
    "Return Delay Time": Register(5, 1, unit="s", per_lsb=2e-6),
    "CW Angle Limit": Register(6, 2, unit="rad", per_lsb=TICK),
    "CCW Angle Limit": Register(8, 2, unit="rad", per_lsb=TICK),
    "Temperature Limit": Register(11, 1, unit="degrees Celsius"),
    "Min Voltage Limit": Register(12, 1, unit="V", per_lsb=0.1),
    "Max Voltage Limit": Register(13, 1, unit="V", per_lsb=0.1),
    "Max Torque": Register(14, 2, per_lsb=1 / 1023),
    "Status Return Level": Register(16, 1),
    "Alarm LED": Register(17, 1),
    "Shutdown": Register(18, 1),
    "Multi Turn Offset": Register(20, 2, Signed.TWOS, unit="rad", per_lsb=TICK),
    "Resolution Divider": Register(22, 1),
    "Torque Enable": Register(24, 1),
    "LED": Register(25, 1),
    "D Gain": Register(26, 1),
    "I Gain": Register(27, 1),
    "P Gain": Register(28, 1),
    "Goal Position": Register(30, 2, unit="rad", per_lsb=TICK),
    "Moving Speed": Register(32, 2, unit="rad/s", per_lsb=SPEED_STEP),  # 0: no limit on the speed
    "Torque Limit": Register(34, 2, per_lsb=1 / 1023),
    "Present Position": Register(36, 2, unit="rad", per_lsb=TICK),
    "Present Speed": Register(38, 2, Signed.BIT_10, unit="rad/s", per_lsb=SPEED_STEP),
    "Present Load": Register(40, 2, Signed.BIT_10, per_lsb=1 / 1023),
    "Present Voltage": Register(42, 1, unit="V", per_lsb=0.1),
    "Present Temperature": Register(43, 1, unit="degrees Celsius"),
    "Registered": Register(44, 1),
    "Moving": Register(46, 1),
    "Lock": Register(47, 1),
    "Punch": Register(48, 2),
    "Realtime Tick": Register(50, 2, unit="s", per_lsb=1e-3),  # from firmware 40 on
    "Goal Acceleration": Register(73, 1, unit="rad/s²", per_lsb=ACCELERATION_STEP),
}

# https://emanual.robotis.com/docs/en/dxl/mx/mx-64/#control-table-of-ram-area
MX_64 = MX_28 | {
    "Current": Register(68, 2, Signed.OFFSET_2048, unit="A", per_lsb=4.5e-3),
    "Torque Ctrl Mode Enable": Register(70, 1),
    "Goal Torque": Register(71, 2, Signed.BIT_10, unit="A", per_lsb=4.5e-3),
}

# https://emanual.robotis.com/docs/en/dxl/mx/mx-106/#control-table-of-eeprom-area
MX_106 = MX_64 | {
    "Drive Mode": Register(10, 1),
}

_NOT_IN_AX = (
    "Multi Turn Offset", "Resolution Divider", "D Gain", "I Gain", "P Gain",
    "Realtime Tick", "Goal Acceleration",
)  # fmt: skip

# https://emanual.robotis.com/docs/en/dxl/ax/ax-12a/#control-table-of-eeprom-area
AX_12A = {name: register for name, register in MX_28.items() if name not in _NOT_IN_AX} | {
    "CW Angle Limit": Register(6, 2, unit="rad", per_lsb=AX_TICK),
    "CCW Angle Limit": Register(8, 2, unit="rad", per_lsb=AX_TICK),
    "CW Compliance Margin": Register(26, 1, unit="rad", per_lsb=AX_TICK),
    "CCW Compliance Margin": Register(27, 1, unit="rad", per_lsb=AX_TICK),
    "CW Compliance Slope": Register(28, 1),
    "CCW Compliance Slope": Register(29, 1),
    "Goal Position": Register(30, 2, unit="rad", per_lsb=AX_TICK),
    "Moving Speed": Register(32, 2, unit="rad/s", per_lsb=AX_SPEED_STEP),  # 0: no limit on the speed
    "Present Position": Register(36, 2, unit="rad", per_lsb=AX_TICK),
    "Present Speed": Register(38, 2, Signed.BIT_10, unit="rad/s", per_lsb=AX_SPEED_STEP),
}

# https://emanual.robotis.com/docs/en/dxl/protocol1/#error
ERRORS = (
    "Input Voltage Error",
    "Angle Limit Error",
    "Overheating Error",
    "Range Error",
    "Checksum Error",
    "Overload Error",
    "Instruction Error",
)
"""Names of the bits of a status packet's error byte, from bit 0; those of Shutdown are the same."""

REFUSED = 0b0101_1010
"""Errors that say an instruction was not carried out: angle limit, range, checksum, instruction.
The other bits are conditions of the servo, under which a reply is valid."""
