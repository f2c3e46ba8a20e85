def execute(self, inputs, outputs, gvm):
    outputs["why"] = str(inputs["error"]).splitlines()[-1]
    return "success"
