def execute(self, inputs, outputs, gvm):
    ends = {}
    for state in ("FINEAA", "NESTED", "COUNTS"):
        outcome = self.get_outcome_for_state_id(state)
        ends[state] = [outcome.outcome_id, outcome.name, self.get_errors_for_state_id(state) is not None]
    by_name = self.get_outcome_for_state_name("goes well")
    outputs["seen"] = {"ends": ends, "by_name": by_name.name, "me": self.state_id,
                       "nobody": self.get_outcome_for_state_id("NOBODY"), "no_error": self.get_errors_for_state_name("counts")}
    well = [state for state, end in ends.items() if end[0] >= 0]
    return {3: "both", 2: "one"}.get(len(well), "none")
