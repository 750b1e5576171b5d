
def sign(x):
    return float(x > 0) - float(x < 0)


def values(changes=None):
    """Values of PARAMETERS in their order, with some of them changed: {name: value}."""
    table = {name: entry[0] for name, entry in PARAMETERS.items()}
    unknown = set(changes or {}) - set(table)
    if unknown:
        raise KeyError(f"no parameter {', '.join(sorted(unknown))}")
    table.update(changes or {})
    return list(table.values())


def balances(t, x, z, u, p):
    return np.array(equations(t, x, z, u, p)[0])


def solve(t, x, z, u, p, memory):
    """The unknowns whose balances are zero, by Newton's method from z. The slopes of the last call serve until they do no more."""
    def converged(step, z):
        return np.max(np.abs(step)) < 1e-9 * (1 + np.max(np.abs(z)))

    z = np.array(z)
    if "inverse" in memory:
        z = z - memory["inverse"] @ balances(t, x, z, u, p)
        step = memory["inverse"] @ balances(t, x, z, u, p)
        if converged(step, z):
            return z - step
    for _ in range(50):
        r = balances(t, x, z, u, p)
        steps = np.diag(1e-6 * (1 + np.abs(z)))
        slopes = np.array([(balances(t, x, z + h, u, p) - r) / np.sum(h) for h in steps]).T
        memory["inverse"] = np.linalg.inv(slopes)
        step = -memory["inverse"] @ r
        while np.max(np.abs(balances(t, x, z + step, u, p))) > np.max(np.abs(r)) and not converged(step, z):
            step = step / 2
        z = z + step
        if converged(step, z):
            break
    return z


def read_inputs(t, columns):
    """Inputs for `simulate` from columns of a recording: {column: values}."""
    inputs = []
    for name, column, scale, offset, take, _ in INPUTS:
        values = np.asarray(columns[column], dtype=float)
        if take == "rate":
            values = make_interp_spline(t, values, k=7).derivative()(t)
        elif take is not None:
            values = (np.cos if take[0] == "cos" else np.sin)(take[1] * values)
        inputs.append(scale * values + offset)
    return np.array(inputs)


def between_samples(t, values, between):
    """A function of time through samples."""
    if between == "band-limited":
        return make_interp_spline(t, values, k=7)
    first, step, last, values = t[0], (t[-1] - t[0]) / (len(t) - 1), len(t) - 2, values.tolist()

    def at(time):
        k = min(max(int((time - first) / step + 1e-9), 0), last)
        share = (time - first) / step - k
        if between == "hold":
            return values[k + (share > 1 - 1e-9)]
        return values[k] + share * (values[k + 1] - values[k])

    return at


def signals(t, inputs):
    """Functions of time: the inputs between their samples, and the derivatives that the equations use."""
    functions = [between_samples(t, own, entry[5]) for entry, own in zip(INPUTS, inputs)]
    return functions + [make_interp_spline(t, inputs[index], k=7).derivative() for index in CHANGES]


def simulate(t, inputs, parameters=None, start=None, rtol=1e-7, atol=1e-9):
    """Outputs, one row for each entry of OUTPUTS, at the times t (s, evenly spaced).

    inputs: one row of SI values for each entry of INPUTS. parameters: {name: value} to change. start: values of STATES at t[0], by default
    zero, that is at rest.
    """
    t, inputs, p = np.asarray(t, dtype=float), np.atleast_2d(inputs), values(parameters)
    if inputs.shape != (len(INPUTS), len(t)):
        raise ValueError(f"inputs must have {len(INPUTS)} rows of {len(t)} values")
    functions = signals(t, inputs)
    guess, memory = [0.0] * UNKNOWNS, {}
    u_at = lambda time: [float(own(time)) for own in functions]

    def unknowns(time, x, u):
        if UNKNOWNS:
            guess[:] = solve(time, x, guess, u, p, memory)
        return guess

    def rates(time, x):
        u = u_at(time)
        return equations(time, x, unknowns(time, x, u), u, p)[1]

    start = np.zeros(len(STATES)) if start is None else np.asarray(start, dtype=float)
    step = (t[-1] - t[0]) / (len(t) - 1)
    solution = solve_ivp(rates, (t[0], t[-1]), start, "LSODA", t, rtol=rtol, atol=atol, max_step=2 * step)
    if not solution.success:
        raise RuntimeError(solution.message)
    outputs = np.empty((len(OUTPUTS), len(t)))
    for k, time in enumerate(t):
        x, u = solution.y[:, k], u_at(time)
        outputs[:, k] = equations(time, x, unknowns(time, x, u), u, p)[2]
    for row, delay in enumerate(DELAYS):
        if delay is not None:
            late = p[list(PARAMETERS).index(delay)]
            outputs[row] = np.interp(t - late, t, outputs[row])
    return outputs


def main():
    """python FILE.py RECORDING.csv: the model on a recording's inputs, against its outputs."""
    import csv
    import sys

    with open(sys.argv[1], newline="") as file:
        rows = list(csv.reader(file))
    table = np.array([[float(cell) if cell else np.nan for cell in row] for row in rows[1:]])
    columns = dict(zip(rows[0], table.T))
    t = columns["t_s"] - columns["t_s"][0]
    outputs = simulate(t, read_inputs(t, columns))
    for (name, column, scale, offset), predicted in zip(OUTPUTS, outputs):
        if column in columns:
            measured = scale * columns[column] + offset
            error = np.sqrt(np.nanmean((predicted - measured) ** 2))
            print(f"{name}: error rms {error:.6g}, of {np.nanstd(measured):.6g}")


if __name__ == "__main__":
    main()
