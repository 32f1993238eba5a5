"""What an orthoptist examines: cover test, prisms, acuity, stereopsis."""
