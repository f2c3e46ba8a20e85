
def execute(self, inputs, outputs, gvm):
    self.logger.info(inputs["text"] + str(inputs["value"]))
    return 0
