"""Every simulated servo model by its name in a config: its control table and its firmware."""

from collections.abc import Mapping

from sim.dynamixel import tables1, tables2
from sim.dynamixel.cells import Cell
from sim.dynamixel.device import Device
from sim.dynamixel.firmware1 import Ax, Firmware1
from sim.dynamixel.firmware2 import Firmware2
from sim.servo import Servo

TABLES = tables1.TABLES | tables2.TABLES

FIRMWARES: Mapping[str, type[Device]] = {
    **dict.fromkeys(tables1.TABLES, Firmware1),
    **dict.fromkeys(tables2.TABLES, Firmware2),
    tables1.AX_12A.name: Ax,
}


def build_device(servo: Servo, provisioned: Mapping[Cell, int]) -> Device:
    """The control table of the model that `servo` is."""
    name = servo.model.name
    return FIRMWARES[name](TABLES[name], servo, provisioned)
