def execute(self, inputs, outputs, gvm):
    return "no such outcome"
