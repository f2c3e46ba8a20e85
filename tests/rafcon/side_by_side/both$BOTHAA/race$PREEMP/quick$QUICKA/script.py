
def execute(self, inputs, outputs, gvm):
    return 0
