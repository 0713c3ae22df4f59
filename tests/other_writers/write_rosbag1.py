#!/usr/bin/python3
"""write_rosbag1.py FOLDER OUT.bag: a recording (cam0/STAMP.pgm, imu0.csv) by ROS's own rosbag."""

import os
import sys

import rosbag
import rospy
from sensor_msgs.msg import Image, Imu


def stamp_of(nanoseconds):
    return rospy.Time(nanoseconds // 1000000000, nanoseconds % 1000000000)


def image_of(path, stamp):
    with open(path, "rb") as file:
        magic, size, depth = (file.readline() for _ in range(3))
        pixels = file.read()
    assert (magic, depth) == (b"P5\n", b"255\n")
    image = Image()
    image.header.stamp = stamp
    image.width, image.height = (int(word) for word in size.split())
    image.step = image.width
    image.encoding = "mono8"
    image.data = pixels
    return image


def imu_of(fields, stamp):
    imu = Imu()
    imu.header.stamp = stamp
    rates, forces = imu.angular_velocity, imu.linear_acceleration
    rates.x, rates.y, rates.z, forces.x, forces.y, forces.z = (float(x) for x in fields)
    return imu


def main(folder, out):
    messages = []
    for name in os.listdir(os.path.join(folder, "cam0")):
        stamp = int(name.replace(".pgm", ""))
        image = image_of(os.path.join(folder, "cam0", name), stamp_of(stamp))
        messages.append((stamp, "/cam0/image_raw", image))
    with open(os.path.join(folder, "imu0.csv")) as file:
        for line in list(file)[1:]:
            fields = line.split(",")
            stamp = int(fields[0])
            messages.append((stamp, "/imu0", imu_of(fields[1:7], stamp_of(stamp))))
    messages.sort(key=lambda message: message[0])
    with rosbag.Bag(out, "w", compression="lz4", chunk_threshold=400000) as bag:
        for stamp, topic, message in messages:
            bag.write(topic, message, stamp_of(stamp))


main(*sys.argv[1:3])
