"""Stand-in of the functions of CoSimIO that examples/cosimio.py calls: two programs and a socket in the present
directory. SPDX-License-Identifier: BSD-3-Clause"""
import time
from multiprocessing.connection import Client, Listener

_lines = {}


class Info:
    def __init__(self):
        self._values = {}

    def SetString(self, key, value):
        if type(value) is not str:
            raise TypeError(f"{key}: {value!r} is no string")
        self._values[key] = value

    def SetInt(self, key, value):
        if type(value) is not int:
            raise TypeError(f"{key}: {value!r} is no whole number")
        self._values[key] = value

    def GetString(self, key):
        return self._values[key]


class DoubleVector(list):
    pass


def Connect(settings):
    name, other = settings.GetString("my_name"), settings.GetString("connect_to")
    first = min(name, other)
    connection_name = "_".join(sorted((name, other)))
    if name == first:
        with Listener(connection_name, "AF_UNIX") as listener:
            _lines[connection_name] = listener.accept()
    else:
        for _ in range(1000):
            try:
                _lines[connection_name] = Client(connection_name, "AF_UNIX")
                break
            except (FileNotFoundError, ConnectionRefusedError):
                time.sleep(0.02)
        else:
            raise RuntimeError(f"no program '{other}'")
    answer = Info()
    answer.SetString("connection_name", connection_name)
    return answer


def ExportData(info, values):
    if not isinstance(values, DoubleVector):
        raise TypeError("ExportData: must be a DoubleVector")
    _lines[info.GetString("connection_name")].send((info.GetString("identifier"), list(values)))


def ImportData(info, values):
    identifier, sent = _lines[info.GetString("connection_name")].recv()
    if identifier != info.GetString("identifier"):
        raise RuntimeError(f"'{identifier}' was sent, '{info.GetString('identifier')}' is expected")
    values[:] = sent


def Disconnect(info):
    _lines.pop(info.GetString("connection_name")).close()
