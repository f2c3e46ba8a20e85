def execute(self, inputs, outputs, gvm):
    raise RuntimeError("broken")
