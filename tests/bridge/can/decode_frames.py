"""Decodes CAN frames with python3-canmatrix, which knows nothing of this project's codec.

decode_frames.py DBC ID#HEX... prints a line per frame: MESSAGE SIGNAL=VALUE ... (physical values).
"""
import sys

import canmatrix
import canmatrix.formats


def main():
    database = next(iter(canmatrix.formats.loadp(sys.argv[1]).values()))
    for text in sys.argv[2:]:
        number, _, payload = text.partition("#")
        frame = database.frame_by_id(canmatrix.ArbitrationId(int(number, 16), False))
        if frame is None:
            raise SystemExit(f"{number}: no such message in {sys.argv[1]}")
        data = bytes.fromhex(payload)
        if len(data) < frame.size:
            raise SystemExit(f"{frame.name}: {len(data)} bytes, the database has {frame.size}")
        decoded = frame.decode(data)
        fields = [f"{name}={float(value.phys_value)!r}" for name, value in decoded.items()]
        print(frame.name, *fields)


main()
