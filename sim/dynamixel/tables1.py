"""Control tables of MX servos with firmware 1 and of AX-12A (protocol 1.0), as simulated servos hold them.

Addresses, sizes, defaults and ranges: https://emanual.robotis.com/docs/en/dxl/mx/mx-28/ (and mx-64, mx-106),
https://emanual.robotis.com/docs/en/dxl/ax/ax-12a/.
Written from the manual for the simulator alone; the driver has its own, so that a mistake shows.
"""

from dataclasses import replace

from sim.dynamixel.cells import Cell, Common, Table

MODEL_NUMBER = Cell(0, 2, 29)
FIRMWARE = Cell(2, 1, 41)
ID = Cell(3, 1, 1, 0, 252)
BAUD = Cell(4, 1, 34, 0, 254)
RETURN_DELAY = Cell(5, 1, 250, 0, 254)
CW_LIMIT = Cell(6, 2, 0, 0, 4095)
CCW_LIMIT = Cell(8, 2, 4095, 0, 4095)
TEMPERATURE_LIMIT = Cell(11, 1, 80, 0, 100)
LOWEST_VOLTAGE = Cell(12, 1, 60, 50, 160)  # 0.1 V
HIGHEST_VOLTAGE = Cell(13, 1, 160, 50, 160)
MAX_TORQUE = Cell(14, 2, 1023, 0, 1023)
RETURN_LEVEL = Cell(16, 1, 2, 0, 2)
ALARM_LED = Cell(17, 1, 36, 0, 127)
SHUTDOWN = Cell(18, 1, 36, 0, 127)
TORQUE_ENABLE = Cell(24, 1, 0, 0, 1)
LED = Cell(25, 1, 0, 0, 1)
P_GAIN = Cell(28, 1, 32, 0, 254)
CW_SLOPE = Cell(28, 1, 32, 1, 254)
CCW_SLOPE = Cell(29, 1, 32, 1, 254)
GOAL = Cell(30, 2, 2048, 0, 4095)
MOVING_SPEED = Cell(32, 2, 0, 0, 2047)
TORQUE_LIMIT = Cell(34, 2, 1023, 0, 1023)
POSITION = Cell(36, 2, 2048)
SPEED = Cell(38, 2, 0)
LOAD = Cell(40, 2, 0)
VOLTAGE = Cell(42, 1, 120)
TEMPERATURE = Cell(43, 1, 25)
REGISTERED = Cell(44, 1, 0)
MOVING = Cell(46, 1, 0)
LOCK = Cell(47, 1, 0, 0, 1)
REALTIME_TICK = Cell(50, 2, 0)
CURRENT = Cell(68, 2, 2048)
GOAL_ACCELERATION = Cell(73, 1, 0, 0, 254)

COMMON = Common(
    MODEL_NUMBER,
    FIRMWARE,
    ID,
    BAUD,
    RETURN_DELAY,
    RETURN_LEVEL,
    CW_LIMIT,
    CCW_LIMIT,
    TORQUE_ENABLE,
    GOAL,
    REGISTERED,
)

_BOTH = (
    ID,
    RETURN_DELAY,
    LOWEST_VOLTAGE,
    MAX_TORQUE,
    RETURN_LEVEL,
    ALARM_LED,
    SHUTDOWN,
    TORQUE_ENABLE,
    LED,
    MOVING_SPEED,
    TORQUE_LIMIT,
    SPEED,
    LOAD,
    VOLTAGE,
    TEMPERATURE,
    REGISTERED,
    MOVING,
    LOCK,
)
"""What MX and AX have alike."""

_MX = (
    *_BOTH,
    FIRMWARE,
    BAUD,
    CW_LIMIT,
    CCW_LIMIT,
    TEMPERATURE_LIMIT,
    HIGHEST_VOLTAGE,
    Cell(20, 2, 0, 0, 65535),  # multi-turn offset
    Cell(22, 1, 1, 1, 4),  # resolution divider
    Cell(26, 1, 0, 0, 254),  # D gain
    Cell(27, 1, 0, 0, 254),  # I gain
    P_GAIN,
    GOAL,
    POSITION,
    Cell(48, 2, 0, 0, 1023),  # punch
    REALTIME_TICK,
    GOAL_ACCELERATION,
)

_AX = (
    Cell(0, 2, 12),
    *_BOTH,
    Cell(2, 1, 24),  # firmware
    Cell(4, 1, 1, 1, 254),  # baud rate
    replace(CW_LIMIT, high=1023),
    replace(CCW_LIMIT, initial=1023, high=1023),
    replace(TEMPERATURE_LIMIT, initial=70),
    replace(HIGHEST_VOLTAGE, initial=140),
    Cell(26, 1, 1, 0, 254),  # CW compliance margin
    Cell(27, 1, 1, 0, 254),  # CCW compliance margin
    CW_SLOPE,
    CCW_SLOPE,
    replace(GOAL, initial=512, high=1023),
    replace(POSITION, initial=512),
    Cell(48, 2, 32, 32, 1023),  # punch
)

_TORQUE_CONTROL = (CURRENT, Cell(70, 1, 0, 0, 1), Cell(71, 2, 0, 0, 2047))
"""What MX-64 and MX-106 have and MX-28 has not: current, torque control mode, goal torque."""

END_OF_EEPROM = 24

RATES = {register: 2_000_000 // (register + 1) for register in range(250)} | {
    250: 2_250_000,
    251: 2_500_000,
    252: 3_000_000,
}
"""bit/s by the Baud Rate register; 250 and above are MX only."""

AX_RATES = {register: rate for register, rate in RATES.items() if rate <= 1_000_000}


def _mx(name: str, *cells: Cell) -> Table:
    return Table(name, COMMON, (*cells, *_MX), 74, END_OF_EEPROM, RATES)


AX_12A = Table("AX-12A", COMMON, _AX, 50, END_OF_EEPROM, AX_RATES, bulk_read=False, turnaround=22e-6)
"""Whether it takes part in a bulk read is contested (DynamixelSDK#40, #46, #386); here it stays silent.
Its turnaround is from xevelabs' notes."""

MX_28 = _mx("MX-28", MODEL_NUMBER)
MX_64 = _mx("MX-64", Cell(0, 2, 310), *_TORQUE_CONTROL)
MX_106 = _mx("MX-106", Cell(0, 2, 320), Cell(10, 1, 0, 0, 3), *_TORQUE_CONTROL)

TABLES = {table.name: table for table in (AX_12A, MX_28, MX_64, MX_106)}
