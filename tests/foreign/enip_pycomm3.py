#!/usr/bin/env python3
"""Runs pycomm3, a client of EtherNet/IP by other authors, with HIPERDRIVE drives: prints a line for each action.

identity             ListIdentity: vendor, serial number, name
get:WAY:N            parameter N of drive 1, its data in hex; WAY is plain, wrapped (Unconnected_Send) or connected
set:WAY:N:HEX        sets it
all                  Get_Attributes_All of the identity object
"""

import logging
import sys

from pycomm3 import CIPDriver

GET, SET = 0x0E, 0x10
WAYS = {
    "plain": {"connected": False, "route_path": False},
    "wrapped": {"connected": False, "unconnected_send": True},
    "connected": {"connected": True},
}


def who(identity):
    return f"{identity['vendor']} {int(identity['serial'], 16)} {identity['product_name']}"


def carry_out(driver, place, thing):
    name, *rest = thing.split(":")
    if name == "identity":
        return who(CIPDriver.list_identity(place))
    if name == "all":
        return who(driver.get_module_info(0))
    way, number, *data = rest
    number = int(number)
    asked = {"class_code": 0x64 + number // 100, "instance": 1, "attribute": number, **WAYS[way]}
    if name == "get":
        tag = driver.generic_message(service=GET, **asked)
    else:
        tag = driver.generic_message(service=SET, request_data=bytes.fromhex(data[0]), **asked)
    return tag.error or tag.value.hex(" ").upper() or "done"


def main():
    # Refusals are printed here, not logged.
    logging.disable(logging.CRITICAL)
    place, things = sys.argv[1], sys.argv[2:]
    with CIPDriver(place) as driver:
        for thing in things:
            print(carry_out(driver, place, thing), flush=True)


if __name__ == "__main__":
    main()
