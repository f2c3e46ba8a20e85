
def execute(self, inputs, outputs, gvm):
    left = self.get_outcome_for_state_name("left")
    error = self.get_errors_for_state_name("right")
    return "fine" if left.name == "success" and "right fails" in str(error) else "bad"
