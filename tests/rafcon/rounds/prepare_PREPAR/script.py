def execute(self, inputs, outputs, gvm):
    gvm.set_variable("limit", 7)
    return "success"
