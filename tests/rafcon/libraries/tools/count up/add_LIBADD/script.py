def execute(self, inputs, outputs, gvm):
    outputs["sum"] = inputs["value"] + inputs["step"]
    return "success"
