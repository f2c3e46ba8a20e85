def execute(self, inputs, outputs, gvm):
    gvm.set_variable("began", True)
    return "success"
