def execute(self, inputs, outputs, gvm):
    raise ValueError("cannot take %d" % inputs["count"])
