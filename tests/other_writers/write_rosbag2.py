#!/usr/bin/python3
"""write_rosbag2.py FOLDER OUT.db3: a recording (cam0/STAMP.pgm, imu0.csv) as ROS 2 stores it.

The tables are those of rosbag2_storage_sqlite3, messages are in CDR, put together here byte by byte.
"""

import os
import sqlite3
import struct
import sys


class Cdr:
    """Little-endian; every number at a multiple of its size, counted from behind the head."""

    def __init__(self, stamp):
        self.bytes = bytearray()
        self.put("i", stamp // 1000000000)
        self.put("I", stamp % 1000000000)
        self.string("rig")

    def put(self, form, value):
        self.bytes += bytes(-len(self.bytes) % struct.calcsize(form))
        self.bytes += struct.pack("<" + form, value)

    def string(self, text):
        self.put("I", len(text) + 1)
        self.bytes += text.encode() + bytes(1)

    def message(self):
        return bytes([0, 1, 0, 0]) + bytes(self.bytes)


def image_message(path, stamp):
    with open(path, "rb") as file:
        magic, size, depth = (file.readline() for _ in range(3))
        pixels = file.read()
    assert (magic, depth) == (b"P5\n", b"255\n")
    width, height = (int(word) for word in size.split())
    cdr = Cdr(stamp)
    cdr.put("I", height)
    cdr.put("I", width)
    cdr.string("mono8")
    cdr.put("B", 0)
    cdr.put("I", width)
    cdr.put("I", len(pixels))
    cdr.bytes += pixels
    return cdr.message()


def imu_message(fields, stamp):
    values = [float(x) for x in fields]
    cdr = Cdr(stamp)
    for x in [0, 0, 0, 1] + [0] * 9 + values[:3] + [0] * 9 + values[3:] + [0] * 9:
        cdr.put("d", x)
    return cdr.message()


def main(folder, out):
    database = sqlite3.connect(out)
    database.execute(
        "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,"
        " serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL)")
    database.execute(
        "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL,"
        " timestamp INTEGER NOT NULL, data BLOB NOT NULL)")
    database.execute("INSERT INTO topics VALUES(1, '/cam0/image_raw', 'sensor_msgs/msg/Image', 'cdr', '')")
    database.execute("INSERT INTO topics VALUES(2, '/imu0', 'sensor_msgs/msg/Imu', 'cdr', '')")
    rows = []
    for name in os.listdir(os.path.join(folder, "cam0")):
        stamp = int(name.replace(".pgm", ""))
        rows.append((1, stamp, image_message(os.path.join(folder, "cam0", name), stamp)))
    with open(os.path.join(folder, "imu0.csv")) as file:
        for line in list(file)[1:]:
            fields = line.split(",")
            stamp = int(fields[0])
            rows.append((2, stamp, imu_message(fields[1:7], stamp)))
    rows.sort(key=lambda row: row[1])
    database.executemany("INSERT INTO messages(topic_id, timestamp, data) VALUES(?, ?, ?)", rows)
    database.commit()
    database.close()


main(*sys.argv[1:3])
