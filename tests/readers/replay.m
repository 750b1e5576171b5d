function replay(name, inputs, recording, predicted)
% Runs an exported function NAME on the columns INPUTS of a recording's first second: Octave interprets.
rows = dlmread(recording, ',', 1, 0);
rows = rows(rows(:, 1) < rows(1, 1) + 1, :);
t = rows(:, 1) - rows(1, 1);
y = feval(name, t, rows(:, inputs));
dlmwrite(predicted, [t y], 'precision', 12);
end
