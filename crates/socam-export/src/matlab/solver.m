
function z = solve(t, x, u, p)
% The unknowns whose balances are zero, by Newton's method. The last solution is the next start.
persistent last
z = zeros(unknowns(), 1);
if isempty(z), return; end
if numel(last) == numel(z) && all(isfinite(last)), z = last; end
for iteration = 1:50
    r = balances(t, x, z, u, p);
    slopes = zeros(numel(z));
    for k = 1:numel(z)
        h = 1e-6*(1 + abs(z(k)));
        moved = z;
        moved(k) = moved(k) + h;
        slopes(:, k) = (balances(t, x, moved, u, p) - r)/h;
    end
    step = -slopes\r;
    while max(abs(balances(t, x, z + step, u, p))) > max(abs(r)) && max(abs(step)) > 1e-9*(1 + max(abs(z)))
        step = step/2;
    end
    z = z + step;
    if max(abs(step)) < 1e-9*(1 + max(abs(z))), break; end
end
last = z;
end

function y = simulate(time, inputs, parameters, first)
% Outputs, one column each, at the times `time` (s, evenly spaced, one column); one column of inputs each, SI. From rest, unless
% `first` gives the states at time(1).
time = time(:);
if nargin < 3 || isempty(parameters), parameters = values(); end
if nargin < 4, first = zeros(state_count(), 1); end
dt = (time(end) - time(1))/(numel(time) - 1);
[kinds, changes, delays] = behaviour();
signals = cell(1, numel(kinds) + numel(changes));
for k = 1:numel(kinds)
    signals{k} = between(time, inputs(:, k), kinds{k}, dt);
end
for k = 1:numel(changes)
    slope = gradient(inputs(:, changes(k)), dt);
    signals{numel(kinds) + k} = between(time, slope, 'linear', dt);
end
at = @(t) cellfun(@(own) own(t), signals).';
options = odeset('RelTol', 1e-6, 'AbsTol', 1e-8, 'MaxStep', 4*dt);
[~, x] = ode15s(@(t, x) second_of(t, x, at(t), parameters), time, first, options);
y = zeros(numel(time), output_count());
for k = 1:numel(time)
    u = at(time(k));
    [~, ~, row] = balances(time(k), x(k, :).', solve(time(k), x(k, :).', u, parameters), u, parameters);
    y(k, :) = row.';
end
for k = 1:numel(delays)
    if delays(k) > 0
        y(:, k) = interp1(time, y(:, k), max(time - parameters(delays(k)), time(1)));
    end
end
end

function rates = second_of(t, x, u, p)
[~, rates] = balances(t, x, solve(t, x, u, p), u, p);
end

function value = between(time, values, kind, dt)
% A function of time through samples.
switch kind
    case 'band-limited'
        pieces = spline(time, values);
        value = @(t) ppval(pieces, t);
    case 'hold'
        value = @(t) values(min(floor((t - time(1))/dt + 1e-9) + 1, numel(values)));
    otherwise
        value = @(t) line_at(values, (t - time(1))/dt);
end
end

function value = line_at(values, place)
k = min(max(floor(place), 0), numel(values) - 2);
value = values(k + 1) + (place - k)*(values(k + 2) - values(k + 1));
end
