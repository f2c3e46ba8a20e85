import threading


class Node:
    """As a ROS node: it has threads and locks, and nobody can copy it."""

    def __init__(self):
        self.lock = threading.Lock()
        self.published = []


def execute(self, inputs, outputs, gvm):
    gvm.set_variable("node", Node(), per_reference=True)
    poses = [1]
    gvm.set_variable("poses", poses, per_reference=True)
    poses.append(2)
    return "success"
