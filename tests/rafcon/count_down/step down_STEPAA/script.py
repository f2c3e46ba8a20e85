
def execute(self, inputs, outputs, gvm):
    outputs["count"] = inputs["count"] - 1
    gvm.set_variable("last", outputs["count"])
    return ">0" if outputs["count"] > 0 else 1
