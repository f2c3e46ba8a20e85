def execute(self, inputs, outputs, gvm):
    node = gvm.get_variable("node", per_reference=True)
    with node.lock:
        node.published.append("pose")
    gvm.set_variable("published", gvm.get_variable("node").published)
    gvm.get_variable("poses", per_reference=True).append(3)
    gvm.delete_variable("node")
    return "success"
