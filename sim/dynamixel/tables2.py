"""Control tables of MX servos with firmware 2 (protocol 2.0), as the simulated servos hold them.

Addresses, sizes, defaults, ranges: https://emanual.robotis.com/docs/en/dxl/mx/mx-28-2/ (mx-64-2, mx-106-2).
Written from the manual for the simulator alone; the driver has its own, so that a mistake shows.
The indirect registers (168 and above) are left out.
"""

from sim.dynamixel.cells import Cell, Common, Table

WORD, LONG = 2**15 - 1, 2**31 - 1

MODEL_NUMBER = Cell(0, 2, 30)
FIRMWARE = Cell(6, 1, 43)
ID = Cell(7, 1, 1, 0, 252)
BAUD = Cell(8, 1, 1, 0, 7)
RETURN_DELAY = Cell(9, 1, 250, 0, 254)
DRIVE_MODE = Cell(10, 1, 0, 0, 13)
OPERATING_MODE = Cell(11, 1, 3, 0, 16)
PROTOCOL_TYPE = Cell(13, 1, 2, 1, 2)
TEMPERATURE_LIMIT = Cell(31, 1, 80, 0, 100)
HIGHEST_VOLTAGE = Cell(32, 2, 160, 95, 160)  # 0.1 V
LOWEST_VOLTAGE = Cell(34, 2, 95, 95, 160)
PWM_LIMIT = Cell(36, 2, 885, 0, 885)
HIGHEST_POSITION = Cell(48, 4, 4095, 0, 4095)
LOWEST_POSITION = Cell(52, 4, 0, 0, 4095)
SHUTDOWN = Cell(63, 1, 52, 0, 255)
TORQUE_ENABLE = Cell(64, 1, 0, 0, 1)
RETURN_LEVEL = Cell(68, 1, 2, 0, 2)
REGISTERED = Cell(69, 1, 0)
HARDWARE_ERROR = Cell(70, 1, 0)
P_GAIN = Cell(84, 2, 850, 0, 16383)
WATCHDOG = Cell(98, 1, 0, 0, 127, signed=True)  # 20 ms
GOAL_PWM = Cell(100, 2, 885, -885, 885, signed=True)
GOAL_CURRENT = Cell(102, 2, 0, -WORD, WORD, signed=True)
GOAL_VELOCITY = Cell(104, 4, 0, -1023, 1023, signed=True)
PROFILE_ACCELERATION = Cell(108, 4, 0, 0, 32767)
PROFILE_VELOCITY = Cell(112, 4, 0, 0, 32767)
GOAL = Cell(116, 4, 2048, -LONG - 1, LONG, signed=True)
REALTIME_TICK = Cell(120, 2, 0)
MOVING = Cell(122, 1, 0)
PWM = Cell(124, 2, 0, signed=True)
LOAD_OR_CURRENT = Cell(126, 2, 0, signed=True)
VELOCITY = Cell(128, 4, 0, signed=True)
POSITION = Cell(132, 4, 2048, signed=True)
VELOCITY_TRAJECTORY = Cell(136, 4, 0, signed=True)
POSITION_TRAJECTORY = Cell(140, 4, 2048, signed=True)
VOLTAGE = Cell(144, 2, 120)
TEMPERATURE = Cell(146, 1, 25)

GOALS = frozenset(cell.address for cell in (GOAL_PWM, GOAL_CURRENT, GOAL_VELOCITY, GOAL))
"""What cannot be written once the watchdog has tripped."""

COMMON = Common(
    MODEL_NUMBER,
    FIRMWARE,
    ID,
    BAUD,
    RETURN_DELAY,
    RETURN_LEVEL,
    LOWEST_POSITION,
    HIGHEST_POSITION,
    TORQUE_ENABLE,
    GOAL,
    REGISTERED,
)

_ALL = (
    Cell(2, 4, 0),  # model information
    FIRMWARE,
    ID,
    BAUD,
    RETURN_DELAY,
    DRIVE_MODE,
    OPERATING_MODE,
    Cell(12, 1, 255, 0, 255),  # shadow id
    PROTOCOL_TYPE,
    Cell(20, 4, 0, -1_044_479, 1_044_479, signed=True),  # homing offset
    Cell(24, 4, 10, 0, 1023),  # moving threshold
    TEMPERATURE_LIMIT,
    HIGHEST_VOLTAGE,
    LOWEST_VOLTAGE,
    PWM_LIMIT,
    Cell(40, 4, 32767, 0, 32767),  # acceleration limit
    HIGHEST_POSITION,
    LOWEST_POSITION,
    SHUTDOWN,
    TORQUE_ENABLE,
    Cell(65, 1, 0, 0, 1),  # LED
    RETURN_LEVEL,
    REGISTERED,
    HARDWARE_ERROR,
    Cell(76, 2, 1920, 0, 16383),  # velocity I gain
    Cell(78, 2, 100, 0, 16383),  # velocity P gain
    Cell(80, 2, 0, 0, 16383),  # position D gain
    Cell(82, 2, 0, 0, 16383),  # position I gain
    P_GAIN,
    Cell(88, 2, 0, 0, 16383),  # feedforward 2nd gain
    Cell(90, 2, 0, 0, 16383),  # feedforward 1st gain
    WATCHDOG,
    GOAL_PWM,
    GOAL_VELOCITY,
    PROFILE_ACCELERATION,
    PROFILE_VELOCITY,
    GOAL,
    REALTIME_TICK,
    MOVING,
    Cell(123, 1, 0),  # moving status
    PWM,
    LOAD_OR_CURRENT,
    VELOCITY,
    POSITION,
    VELOCITY_TRAJECTORY,
    POSITION_TRAJECTORY,
    VOLTAGE,
    TEMPERATURE,
)

RATES = {
    0: 9_600,
    1: 57_600,
    2: 115_200,
    3: 1_000_000,
    4: 2_000_000,
    5: 3_000_000,
    6: 4_000_000,
    7: 4_500_000,
}
"""bit/s by the Baud Rate register."""


def _mx(name: str, *cells: Cell) -> Table:
    return Table(name, COMMON, (*cells, *_ALL), 147, 64, RATES)


def _velocity_limit(value: int) -> Cell:
    return Cell(44, 4, value, 0, 1023)  # 0.229 rpm


def _current_limit(value: int) -> Cell:
    return Cell(38, 2, value, 0, value)  # 3.36 mA


MX_28 = _mx("MX-28(2.0)", MODEL_NUMBER, _velocity_limit(230))
MX_64 = _mx("MX-64(2.0)", Cell(0, 2, 311), _velocity_limit(285), _current_limit(1941), GOAL_CURRENT)
MX_106 = _mx("MX-106(2.0)", Cell(0, 2, 321), _velocity_limit(210), _current_limit(2047), GOAL_CURRENT)

TABLES = {table.name: table for table in (MX_28, MX_64, MX_106)}
