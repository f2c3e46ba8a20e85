def execute(self, inputs, outputs, gvm):
    return "right"
