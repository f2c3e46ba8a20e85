def execute(self, inputs, outputs, gvm):
    outputs["handled"] = inputs["handled"]
    gvm.delete_variable("waits")
    return "won" if inputs["who"] == "quick" else "lost"
