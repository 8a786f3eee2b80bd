"""What the operator sees. Widgets get their data by constructor or setter and speak by signals; they open no file."""
