"""What leaves the program: tables, GIS files, figures and the PDF report."""
